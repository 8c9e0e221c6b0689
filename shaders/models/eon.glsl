/*---
provides = ["model"]
name = "eon"
title = "Energy-preserving Oren-Nayar"
source = "Portsmouth, Kutz, Hill 2024 (EON), eq. 16 to 19, with the analytic albedo of eq. 12"
singular = ["multiple-scattering lobe is 0/0 at roughness 0 as printed", "1 - E cancels towards grazing as printed"]
black = { albedo = 0.0 }
[left_out]
"multiple-scattering lobe" = { roughness = 0.0 }
"albedo factor" = { albedo = 1.0 }
[parameters.roughness]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "interpolation weight r from Lambert (0) to fully rough (1)"
[parameters.albedo]
min = 0.0
max = 1.0
default = 1.0
unit = ""
help = "single-scattering albedo rho, one colour channel"
---*/
#include "common/fon.glsl"

// Eq. 19 with (1 - Ei)(1 - Eo)/(1 - Eavg) reduced by A r/pi, which is 0/0 at roughness 0.
float multiple_scattering(float mu_i, float mu_o) {
    float strength = eon_multiple_scattering_albedo(albedo, roughness) * fon_amplitude(roughness) * roughness;
    return strength * 0.149794500641183 * fon_deficit(mu_o) * fon_deficit(mu_i); // 1/(pi^3 (C1 - C2))
}

float brdf(vec3 wi, vec3 wo) {
    float f = albedo * fon_lobe(wi, wo, roughness) + multiple_scattering(wi.z, wo.z);
    return wi.z > 0.0 && wo.z > 0.0 ? f : 0.0;
}

float directional_albedo(float mu) {
    float scattered_again = eon_multiple_scattering_albedo(albedo, roughness);
    return albedo + (scattered_again - albedo) * fon_missing_energy(mu, roughness);
}
