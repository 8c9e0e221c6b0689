/*---
provides = ["model"]
name = "oren-nayar-full"
title = "Full Oren-Nayar"
source = "Oren and Nayar 1994, direct term and interreflection (the model that Portsmouth, Kutz, Hill 2024 call fullON)"
singular = ["polar angles and azimuth are 0/0 at the normal", "negative in forward grazing scattering at low albedo"]
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

float brdf(vec3 wi, vec3 wo) {
    float theta_i = polar_angle(wi);
    float theta_o = polar_angle(wo);
    float smaller = min(theta_i, theta_o);
    float ratio = smaller / HALF_PI;
    float sine_i = length(wi.xy);
    float sine_o = length(wo.xy);
    float sines = sine_i * sine_o;
    float azimuth_cosine = sines > 0.0 ? clamp(tangential_dot(wi, wo) / sines, -1.0, 1.0) : 0.0;
    float tangent_of_smaller = min(sine_i, sine_o) / max(wi.z, wo.z);
    float tangent_of_mean = (sine_i + sine_o) / (wi.z + wo.z);
    float shadowed = azimuth_cosine < 0.0 ? ratio * ratio * ratio : 0.0;

    float c1 = 1.0 - 0.5 * roughness_ratio(sigma, 0.33);
    float c2 = 0.45 * roughness_ratio(sigma, 0.09) * (max(sine_i, sine_o) - shadowed);
    float angles = theta_i * theta_o / (HALF_PI * HALF_PI);
    float c3 = 0.125 * roughness_ratio(sigma, 0.09) * angles * angles;
    float direct = c1 + azimuth_cosine * c2 * tangent_of_smaller + (1.0 - abs(azimuth_cosine)) * c3 * tangent_of_mean;
    float interreflected = 0.17 * albedo * roughness_ratio(sigma, 0.13) * (1.0 - azimuth_cosine * ratio * ratio);
    return wi.z > 0.0 && wo.z > 0.0 ? albedo * INV_PI * (direct + interreflected) : 0.0;
}
