/*---
provides = ["model"]
name = "qon"
title = "Qualitative Oren-Nayar"
source = "Oren and Nayar 1994; Portsmouth, Kutz, Hill 2024 (EON), eq. 1 to 8"
black = { albedo = 0.0 }
[left_out]
"roughness terms" = { sigma = 0.0 }
"albedo factor" = { albedo = 1.0 }
[parameters.sigma]
min = 0.0
max = 1.5707963267948966
default = 1.0
unit = "radians"
help = "standard deviation of the facet slope angle, from Lambert (0)"
[parameters.albedo]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "single-scattering albedo rho, one colour channel"
---*/
#include "common/oren-nayar.glsl"

float amplitude() {
    return 1.0 - 0.5 * roughness_ratio(sigma, 0.33);
}

float slope() {
    return 0.45 * roughness_ratio(sigma, 0.09);
}

float brdf(vec3 wi, vec3 wo) {
    return wi.z > 0.0 && wo.z > 0.0 ? albedo * INV_PI * qualitative_lobe(wi, wo, amplitude(), slope()) : 0.0;
}

float directional_albedo(float mu) {
    return albedo * (amplitude() + slope() * qualitative_shape(mu));
}
