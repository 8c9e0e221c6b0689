// The half vector of a pair of directions, and sampling through it. It is kept as its slope, tan(theta_h) times the
// direction of its azimuth, because 1 - cos^2(theta_h) loses all digits for narrow lobes.
#ifndef SAMPLERSCOPE_HALF_VECTOR
#define SAMPLERSCOPE_HALF_VECTOR

#include "common/exponential.glsl"

struct HalfVector {
    vec2 slope;      // tan(theta_h) (cos phi_h, sin phi_h)
    float tangent2;  // tan^2(theta_h)
    float cosine;    // n.h
    float to_view;   // wo.h, which is wi.h
    float apart;     // 1 - wo.h
};

// Of two directions on the sphere, up to the sign of the slope. wo.h = |wi + wo|/2 has no cancellation at grazing, nor
// has 1 - (wo.h)^2 = |wi - wo|^2/4 near retro-reflection. Defined everywhere: slopes are cut at 1e18, which a horizontal
// sum has as well; the half vector of wi = -wo counts as the normal, with wo.h = 0.
HalfVector half_vector(vec3 wi, vec3 wo) {
    vec3 h = wi + wo;
    float largest = max(max(abs(h.x), abs(h.y)), abs(h.z));
    h = largest > 0.0 ? h / largest : vec3(0.0, 0.0, 1.0); // squares of tiny components have no float32
    vec2 slope = h.xy / max(abs(h.z), 1.0e-18);
    float tangent2 = dot(slope, slope);
    float to_view = 0.5 * largest * sqrt(dot(h, h));
    float apart = 0.25 * dot(wi - wo, wi - wo) / (1.0 + to_view);
    return HalfVector(slope, tangent2, 1.0 / sqrt(1.0 + tangent2), to_view, apart);
}

// The mirror image of wo about the half vector of this slope.
vec3 reflect_about(vec3 wo, vec2 slope) {
    vec3 h = vec3(slope, 1.0);
    return 2.0 * dot(wo, h) / dot(h, h) * h - wo;
}

// share times the density of wi, given that of h as scale exp(x), both per steradian (Walter's Jacobian 1/(4 wo.h)). It
// covers the sphere: directions below the horizon are drawn too. wi = -wo, which h drawn at a right angle to wo gives,
// counts as never drawn.
float reflected_density(float share, float scale, float x, HalfVector h) {
    return h.to_view > 0.0 ? exponential_ratio(share, 0.25 * scale, x, h.to_view, 1.0) : 0.0;
}

// Schlick's approximation of Fresnel reflectance.
float schlick(float f0, HalfVector h) {
    float squared = h.apart * h.apart;
    return f0 + (1.0 - f0) * squared * squared * h.apart;
}

// 1 - F without its cancellation at grazing: 1 - x^5 is 1 - x times a sum of positive terms.
float schlick_rest(float f0, HalfVector h) {
    float x = h.apart;
    return (1.0 - f0) * h.to_view * (1.0 + x * (1.0 + x * (1.0 + x * (1.0 + x))));
}

#endif
