"""Contracts that every other package builds on: errors, outcomes, skills, ports, clocks."""
