"""Whether a model and technique stay right where formulas break: edges, seams, poles and stiff places."""
