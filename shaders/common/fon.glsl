// The Fujii Oren-Nayar lobe and its albedo, in forms that stay accurate at grazing view and at roughness 0.
// Source: Portsmouth, Kutz, Hill, "EON: A practical energy-preserving rough diffuse BRDF" (2024), eq. 10 to 15.
#ifndef SAMPLERSCOPE_FON
#define SAMPLERSCOPE_FON

#include "common/arc.glsl"

const float FON_C1 = 0.287793409210806; // 1/2 - 2/(3 pi)
const float FON_C2 = 0.0724882124569239; // 2/3 - 28/(15 pi)

// A of eq. 10.
float fon_amplitude(float r) {
    return 1.0 / (1.0 + FON_C1 * r);
}

// s/t of eq. 11. s is formed from the tangential parts, which do not cancel at grazing.
float fon_s_over_t(vec3 wi, vec3 wo) {
    float s = wi.x * wo.x + wi.y * wo.y;
    return s > 0.0 ? s / (wi.z > wo.z ? wi.z : wo.z) : s;
}

// f/rho of the single-scattering lobe (eq. 10), 1/sr.
float fon_lobe(vec3 wi, vec3 wo, float r) {
    return INV_PI * fon_amplitude(r) * (1.0 + r * fon_s_over_t(wi, wo));
}

// D with 1 - E = A r D / pi, E the albedo at rho = 1 (eq. 12). 1 - E is never formed from E, which would lose all digits
// towards grazing, where E tends to 1.
float fon_deficit(float mu) {
    float s = sqrt(abs((1.0 - mu) * (1.0 + mu))); // rounding may take mu beyond 1
    float quotient = mu * (0.904129660128230 * mu - 0.666666666666667 * s * (1.0 + s + s * s)) / (1.0 + s);
    return quotient + s * (quadrant_angle(mu, s) + s * mu);
}

// 1 - E(mu), relatively accurate on all of [0, 1].
float fon_missing_energy(float mu, float r) {
    return fon_amplitude(r) * r * INV_PI * fon_deficit(mu);
}

// Average albedo at rho = 1 (eq. 15).
float fon_average_albedo(float r) {
    return fon_amplitude(r) * (1.0 + FON_C2 * r);
}

// rho_ms of eq. 19: what the multiple-scattering lobe returns of the energy it receives.
float eon_multiple_scattering_albedo(float rho, float r) {
    float average = fon_average_albedo(r);
    return rho * rho * average / (1.0 - rho * (1.0 - average));
}

#endif
