/*---
provides = ["model"]
name = "fon"
title = "Fujii Oren-Nayar"
source = "Portsmouth, Kutz, Hill 2024 (EON), eq. 10 and 11"
black = { albedo = 0.0 }
[left_out]
"roughness term" = { roughness = 0.0 }
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

float brdf(vec3 wi, vec3 wo) {
    return wi.z > 0.0 && wo.z > 0.0 ? albedo * fon_lobe(wi, wo, roughness) : 0.0;
}

float directional_albedo(float mu) {
    return albedo * (1.0 - fon_missing_energy(mu, roughness));
}
