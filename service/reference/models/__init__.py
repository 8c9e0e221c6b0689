"""Float64 references of BRDF models, one file each; the file name is the model's name with `-` as `_`."""
