"""Sampler statistics: catalogue, scene, variant, statistics, reference, figures, and the command line on top."""
