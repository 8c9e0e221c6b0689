// The anisotropic distribution of Trowbridge and Reitz (GGX) with its masking after Smith.
// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces" (2007), eq. 33 to 36; Heitz,
// "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs" (2014), eq. 72 and 99.
#ifndef SAMPLERSCOPE_GGX
#define SAMPLERSCOPE_GGX

#include "common/circle.glsl"
#include "common/half-vector.glsl"

// 1/((hx/mx)^2 + (hy/my)^2 + hz^2). Of components, not of slopes, whose squares have no float32 at the horizon.
float ggx_squared_stretch(HalfVector h, float mx, float my) {
    vec2 scaled = h.slope * h.cosine / vec2(mx, my);
    return 1.0 / (dot(scaled, scaled) + h.cosine * h.cosine);
}

// D. The integral of D with the cosine is 1.
float ggx_distribution(HalfVector h, float mx, float my) {
    float stretch = ggx_squared_stretch(h, mx, my);
    return stretch * stretch / (PI * mx * my);
}

// The direction in the space where the facets are those of a sphere. Its length is (1 + 2 Lambda) cos.
vec3 ggx_stretched(vec3 w, float mx, float my) {
    return vec3(w.xy * vec2(mx, my), w.z);
}

// reflectance D G2/(4 ci co). Over the cosines, 1 + Lambda(wi) + Lambda(wo) is half of a sum of positive terms that is 0 only
// where both are, so nothing is divided by one cosine. 2^60 keeps the digits of tiny cosines and reflectances.
float ggx_lobe(float reflectance, HalfVector h, vec3 wi, vec3 wo, float mx, float my) {
    const float scale = 1152921504606846976.0;
    float unshadowed = length(ggx_stretched(wi, mx, my)) * (scale * wo.z)
        + length(ggx_stretched(wo, mx, my)) * (scale * wi.z);
    return 0.5 * ggx_distribution(h, mx, my) * (scale * reflectance) / unshadowed;
}

// Slope of a half vector with density D cos (Walter's eq. 35, 36): tan^2 = u1/(1 - u1) where mx and my are 1.
vec2 ggx_slope(vec2 u, float mx, float my) {
    return sqrt(u.x / (1.0 - u.x)) * vec2(mx, my) * point_on_circle(u.y);
}

#endif
