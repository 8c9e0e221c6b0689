"""Vulkan compute on Mesa lavapipe. Knows nothing of BRDFs."""
