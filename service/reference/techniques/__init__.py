"""Float64 references of sampling techniques, one file each; the file name is the name with `-` as `_`."""
