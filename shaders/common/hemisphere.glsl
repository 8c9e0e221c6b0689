// The two elementary lobes on the hemisphere.
#ifndef SAMPLERSCOPE_HEMISPHERE
#define SAMPLERSCOPE_HEMISPHERE

#include "common/circle.glsl"

const float UNIFORM_DENSITY = 0.159154943091895; // 1/(2 pi)

// Density cos/pi. u1 is the squared cosine: directions close to the horizon, where weights are large, lie at u1 = 0.
DirectionSample cosine_hemisphere(vec2 u) {
    float cosine = sqrt(u.x);
    return DirectionSample(vec3(sqrt(1.0 - u.x) * point_on_circle(u.y), cosine), INV_PI * cosine);
}

// Density 1/(2 pi): the cosine itself is uniform.
DirectionSample uniform_hemisphere(vec2 u) {
    return DirectionSample(vec3(sqrt((1.0 - u.x) * (1.0 + u.x)) * point_on_circle(u.y), u.x), UNIFORM_DENSITY);
}

#endif
