"""Labelled products in RGB-D images: what stands apart, how it looks, what is written on it."""
