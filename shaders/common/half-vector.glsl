// The half vector of a pair of directions, and sampling through it. It is kept as its slope, tan(theta_h) times the
// direction of its azimuth, because 1 - cos^2(theta_h) loses all digits for narrow lobes.
#ifndef SAMPLERSCOPE_HALF_VECTOR
#define SAMPLERSCOPE_HALF_VECTOR

struct HalfVector {
    vec2 slope;      // tan(theta_h) (cos phi_h, sin phi_h)
    float tangent2;  // tan^2(theta_h)
    float cosine;    // n.h
    float to_view;   // wo.h, which is wi.h
};

// Of two directions on the sphere; where their sum points down, of its opposite. wo.h = (ci + co)/(2 n.h) has no
// cancellation at grazing. Where the sum is horizontal the slope has no bound: callers get a tangent2 that is huge.
HalfVector half_vector(vec3 wi, vec3 wo) {
    float height = wi.z + wo.z;
    vec2 slope = (wi.xy + wo.xy) / (height == 0.0 ? 1.0e-18 : height);
    float tangent2 = min(dot(slope, slope), 1.0e18);
    float cosine = inversesqrt(1.0 + tangent2);
    return HalfVector(slope, tangent2, cosine, 0.5 * abs(height) / cosine);
}

// The mirror image of wo about the half vector of this slope.
vec3 reflect_about(vec3 wo, vec2 slope) {
    vec3 h = vec3(slope, 1.0) * inversesqrt(1.0 + dot(slope, slope));
    return 2.0 * dot(wo, h) * h - wo;
}

// The density of wi, given that of h, both per steradian (Walter's Jacobian 1/(4 wo.h)). It covers the sphere: directions
// below the horizon are drawn too. wi = -wo, which h drawn at a right angle to wo gives, counts as never drawn.
float reflected_density(float density, HalfVector h) {
    return h.to_view > 0.0 ? density / (4.0 * h.to_view) : 0.0;
}

// Schlick's approximation of Fresnel reflectance.
float schlick(float f0, float to_view) {
    float x = max(1.0 - to_view, 0.0);
    float squared = x * x;
    return f0 + (1.0 - f0) * squared * squared * x;
}

#endif
