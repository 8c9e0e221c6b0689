/*---
provides = ["model"]
name = "eon-approx"
title = "Energy-preserving Oren-Nayar, fitted albedo"
source = "Portsmouth, Kutz, Hill 2024 (EON), eq. 16 to 19, with the polynomial albedo of eq. 14 and the clamps of Listing 1"
singular = ["the fitted albedo passes 1 towards grazing, where 1 - E is clamped to 1e-7"]
black = { albedo = 0.0 }
[left_out]
"fit of the multiple-scattering lobe" = { roughness = 0.0 }
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

const float CLAMP = 1.0e-7;

// G/pi of eq. 14.
float fitted_shape(float mu) {
    float x = 1.0 - mu;
    return x * (0.0571085289 + x * (0.491881867 + x * (-0.332181442 + x * 0.0714429953)));
}

// 1 - A (1 + r G/pi), with the 1 cancelled by hand: A r (C1 - G/pi).
float fitted_missing_energy(float mu) {
    return max(fon_amplitude(roughness) * roughness * (FON_C1 - fitted_shape(mu)), CLAMP);
}

float average_missing_energy() {
    return max(fon_amplitude(roughness) * roughness * (FON_C1 - FON_C2), CLAMP);
}

float brdf(vec3 wi, vec3 wo) {
    float strength = INV_PI * eon_multiple_scattering_albedo(albedo, roughness) / average_missing_energy();
    float multiple = strength * fitted_missing_energy(wo.z) * fitted_missing_energy(wi.z);
    return wi.z > 0.0 && wo.z > 0.0 ? albedo * fon_lobe(wi, wo, roughness) + multiple : 0.0;
}

// The exact integral of this very lobe: the fit's own average albedo is 0.0725612096 r in place of C2 r. The clamp of
// the fit below mu = 0.0116 changes the integral by less than 1e-9.
float directional_albedo(float mu) {
    float single = albedo * (1.0 - fon_missing_energy(mu, roughness));
    float fit_average_missing = fon_amplitude(roughness) * roughness * (FON_C1 - 0.07256120962);
    return single + eon_multiple_scattering_albedo(albedo, roughness) * fitted_missing_energy(mu)
        * max(fit_average_missing, CLAMP) / average_missing_energy();
}
