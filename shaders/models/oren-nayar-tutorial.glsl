/*---
provides = ["model"]
name = "oren-nayar-tutorial"
title = "Oren-Nayar of a GLSL tutorial (negative example)"
source = "A widespread shader tutorial: the cosine of the difference of the polar angles stands where that of the azimuths belongs. Not an Oren-Nayar model; kept because it is shipped"
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

// max(0, cos(theta_o - theta_i)) sin a tan b: the azimuth does not enter.
float polar_term(vec3 wi, vec3 wo) {
    float sine_i = length(wi.xy);
    float sine_o = length(wo.xy);
    return max(wi.z * wo.z + sine_i * sine_o, 0.0) * sine_i * sine_o / max(wi.z, wo.z);
}

float amplitude() {
    return 1.0 - 0.5 * roughness_ratio(sigma, 0.57);
}

float slope() {
    return 0.45 * roughness_ratio(sigma, 0.09);
}

float brdf(vec3 wi, vec3 wo) {
    float f = albedo * INV_PI * (amplitude() + slope() * polar_term(wi, wo));
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}

// The polar term times sin cos, integrated over the angle of wi from the normal to that of wo, and from there on.
float directional_albedo(float mu) {
    float c = clamp(mu, 0.0, 1.0);
    float s = sqrt((1.0 - c) * (1.0 + c));
    float theta = quadrant_angle(s, c);
    float steeper = s * (c * s * s * s / 3.0 + s * (0.666666666666667 - c + c * c * c / 3.0));
    float sine_of_four = 4.0 * s * c * (1.0 - 2.0 * s * s);
    float lower = s * (0.19634954084936207 - 0.125 * theta + sine_of_four / 32.0) + 0.25 * s * s * c * (1.0 + s * s);
    return albedo * (amplitude() + 2.0 * slope() * (steeper + lower));
}
