// Parts of the Oren-Nayar family. sigma is the standard deviation of the facet slope angle, in radians.
// Source: Oren and Nayar, "Generalization of Lambert's Reflectance Model" (1994), in the notation of Portsmouth, Kutz,
// Hill 2024 (EON), section 1.
#ifndef SAMPLERSCOPE_OREN_NAYAR
#define SAMPLERSCOPE_OREN_NAYAR

#include "common/arc.glsl"

// S(c) = sigma^2/(sigma^2 + c), which every coefficient is made of.
float roughness_ratio(float sigma, float c) {
    float squared = sigma * sigma;
    return squared / (squared + c);
}

// s = wi.wo - ci co, from the tangential parts, which do not cancel at grazing.
float tangential_dot(vec3 wi, vec3 wo) {
    return wi.x * wo.x + wi.y * wo.y;
}

// s/max(ci, co) = cos(dphi) sin a tan b, without an angle in it.
float s_over_larger_cosine(vec3 wi, vec3 wo) {
    return tangential_dot(wi, wo) / max(wi.z, wo.z);
}

// The qualitative model for one white channel times pi: A + B max(0, s)/max(ci, co).
float qualitative_lobe(vec3 wi, vec3 wo, float a, float b) {
    return a + b * max(s_over_larger_cosine(wi, wo), 0.0);
}

// Gq(theta)/pi, whose multiple B is added to A by the cosine-weighted integral of that lobe: with s = sin theta,
// Gq = s (theta - s c) + 2/3 tan(theta) (1 - s^3), the last term without its 0 * inf at grazing.
float qualitative_shape(float mu) {
    float c = clamp(mu, 0.0, 1.0);
    float s = sqrt((1.0 - c) * (1.0 + c));
    float theta = quadrant_angle(s, c);
    return 0.318309886183791 * s * (theta - s * c + 0.666666666666667 * c * (1.0 + s + s * s) / (1.0 + s));
}

#endif
