"""Routines as files for machines that other programs drive."""
