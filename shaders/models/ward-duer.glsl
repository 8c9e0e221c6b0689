/*---
provides = ["model"]
name = "ward-duer"
title = "Ward-Duer"
source = "Duer, On the Ward model for global illumination (2005)"
anisotropic = true
singular = ["grows like 1/cos at grazing"]
black = { ks = 0.0 }
[parameters.ks]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "specular reflectance, one colour channel"
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

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float f = exponential_ratio(ks, 1.0 / (4.0 * PI * mx * my), beckmann_exponent(h, mx, my), wi.z, wo.z);
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
