"""Campaigns: one mission run over seeds and settings, and what the runs come to together."""
