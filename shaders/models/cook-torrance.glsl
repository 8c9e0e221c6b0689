/*---
provides = ["model"]
name = "cook-torrance"
title = "Cook-Torrance"
source = "Cook and Torrance, A reflectance model for computer graphics (1982), with an anisotropic Beckmann distribution and the normalization 1/(4 ci co)"
anisotropic = true
[parameters.f0]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "Fresnel reflectance at normal incidence"
[parameters.mx]
min = 0.001
max = 10.0
default = 0.3
unit = ""
help = "root mean square slope of the facets along x"
[parameters.my]
min = 0.001
max = 10.0
default = 0.3
unit = ""
help = "root mean square slope of the facets along y"
---*/
#include "common/beckmann.glsl"

// The V cavity of Cook and Torrance: the part of a facet that is neither shadowed nor masked.
float unshadowed(HalfVector h, float ci, float co) {
    return min(1.0, 2.0 * h.cosine * min(ci, co) / h.to_view);
}

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float shadowing = unshadowed(h, wi.z, wo.z);
    float f = schlick(f0, h.to_view) * beckmann(h, mx, my) * shadowing / (4.0 * (wi.z * wo.z));
    return min(wi.z, wo.z) > 0.0 ? f : 0.0;
}
