/*---
provides = ["model"]
name = "ashikhmin-shirley"
title = "Ashikhmin-Shirley"
source = "Ashikhmin and Shirley, An anisotropic Phong BRDF model (2000), specular lobe"
anisotropic = true
singular = ["the exponent is 0/0 at the normal as printed"]
[left_out]
"Fresnel term" = { f0 = 1.0 }
[parameters.f0]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "Fresnel reflectance at normal incidence"
[parameters.nu]
min = 0.0
max = 1000000.0
default = 100.0
unit = ""
help = "Phong exponent along x"
[parameters.nv]
min = 0.0
max = 1000000.0
default = 100.0
unit = ""
help = "Phong exponent along y"
---*/
#include "common/phong.glsl"

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float scale = 0.25 * phong_scale(nu, nv);
    float f = exponential_ratio(schlick(f0, h), scale, phong_exponent(h, nu, nv), h.to_view, max(wi.z, wo.z));
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
