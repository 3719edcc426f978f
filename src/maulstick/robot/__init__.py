"""Machines that draw: one abstract robot, and one adapter per machine."""
