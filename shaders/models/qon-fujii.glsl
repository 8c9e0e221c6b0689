/*---
provides = ["model"]
name = "qon-fujii"
title = "Qualitative Oren-Nayar, Fujii's proposal"
source = "Fujii's qualitative model with interreflection; Portsmouth, Kutz, Hill 2024 (EON), section 1"
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
    return 1.0 - 0.5 * roughness_ratio(sigma, 0.33) + 0.17 * albedo * roughness_ratio(sigma, 0.13);
}

float slope() {
    return 0.45 * roughness_ratio(sigma, 0.09);
}

float brdf(vec3 wi, vec3 wo) {
    float s = tangential_dot(wi, wo);
    float f = albedo * INV_PI * (amplitude() + slope() * (s > 0.0 ? s / max(wi.z, wo.z) : s));
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}

float directional_albedo(float mu) {
    float s = sqrt((1.0 - mu) * (1.0 + mu));
    return albedo * (amplitude() + slope() * (qualitative_shape(mu) - 0.212206590789194 * s)); // 2/(3 pi)
}
