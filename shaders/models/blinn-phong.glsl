/*---
provides = ["model"]
name = "blinn-phong"
title = "Blinn-Phong, normalized"
source = "Blinn, Models of light reflection for computer synthesized pictures (1977), with the normalization (n + 2)(n + 4)/(8 pi (2^(-n/2) + n))"
black = { ks = 0.0 }
[parameters.ks]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "specular reflectance, one colour channel"
[parameters.n]
min = 0.0
max = 1000000.0
default = 100.0
unit = ""
help = "Phong exponent"
---*/
#include "common/phong.glsl"

float brdf(vec3 wi, vec3 wo) {
    HalfVector h = half_vector(wi, wo);
    float scale = (n + 2.0) * (n + 4.0) / (8.0 * PI * (exp2(-0.5 * n) + n));
    float f = exponential_ratio(ks, scale, phong_exponent(h, n, n), 1.0, 1.0);
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}
