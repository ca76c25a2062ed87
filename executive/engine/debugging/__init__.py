"""Breakpoints, stepping and forced answers while a mission runs."""
