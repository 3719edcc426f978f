"""Machines that draw: one abstract robot, and an adapter a machine."""
