/*---
provides = ["model"]
name = "ggx"
title = "GGX (Trowbridge-Reitz)"
source = "Walter et al., Microfacet Models for Refraction through Rough Surfaces (2007), eq. 33, with Smith's height-correlated masking and shadowing: Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs (2014), eq. 72 and 99"
anisotropic = true
[left_out]
"Fresnel term" = { f0 = 1.0 }
[parameters.f0]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "Fresnel reflectance at normal incidence"
[parameters.mx] # 0.001 as for the other lobes of half vectors: there a float32 step of a direction is 1e-4 of the lobe
min = 0.001
max = 10.0
default = 0.3
unit = ""
help = "alpha along x: the slope at which facets are a quarter as frequent as flat ones"
[parameters.my]
min = 0.001
max = 10.0
default = 0.3
unit = ""
help = "alpha along y"
---*/
#include "common/ggx.glsl"

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float f = ggx_lobe(schlick(f0, h), h, wi, wo, mx, my);
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
