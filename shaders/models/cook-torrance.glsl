/*---
provides = ["model"]
name = "cook-torrance"
title = "Cook-Torrance"
source = "Cook and Torrance, A reflectance model for computer graphics (1982), with an anisotropic Beckmann distribution and the normalization 1/(4 ci co)"
anisotropic = true
[left_out]
"Fresnel term" = { f0 = 1.0 }
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

// ci co over the V cavity of Cook and Torrance, min(1, 2 n.h min(ci, co)/wo.h), as a product of two: max(ci, co) and this.
float unshadowed_cosine(HalfVector h, float ci, float co) {
    return max(min(ci, co), 0.5 * h.to_view / h.cosine);
}

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float scale = 0.25 * beckmann_scale(h, mx, my);
    float x = beckmann_exponent(h, mx, my);
    float f = exponential_ratio(schlick(f0, h), scale, x, max(wi.z, wo.z), unshadowed_cosine(h, wi.z, wo.z));
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
