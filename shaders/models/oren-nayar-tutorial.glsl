/*---
provides = ["model"]
name = "oren-nayar-tutorial"
title = "Oren-Nayar of a GLSL tutorial (negative example)"
source = "A widespread shader tutorial: the cosine of the difference of the polar angles stands where that of the azimuths belongs. Not an Oren-Nayar model; kept because it is shipped"
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

// max(0, cos(theta_o - theta_i)) sin a tan b: the azimuth does not enter.
float polar_term(vec3 wi, vec3 wo) {
    float sine_i = length(wi.xy);
    float sine_o = length(wo.xy);
    return max(wi.z * wo.z + sine_i * sine_o, 0.0) * sine_i * sine_o / max(wi.z, wo.z);
}

float brdf(vec3 wi, vec3 wo) {
    float a = 1.0 - 0.5 * roughness_ratio(sigma, 0.57);
    float b = 0.45 * roughness_ratio(sigma, 0.09);
    return min(wi.z, wo.z) > 0.0 ? albedo * INV_PI * (a + b * polar_term(wi, wo)) : 0.0;
}
