/*---
provides = ["technique"]
name = "printed-half-vector"
title = "Beckmann half vector with the two angles as they are printed"
source = "Kurt, Szirmay-Kalos, Krivanek 2010, eq. 16, 17 and 20; for comparison with shaders/common/beckmann.glsl"
models = ["kurt-plausible", "kurt", "kurt-coupled"]
uses = ["mx", "my"]
below_horizon = true
---*/
#include "common/beckmann.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return beckmann_density(1.0, half_vector(wi, wo), mx, my);
}

DirectionSample sample_direction(vec3 wo, vec2 u) {
    float phi = atan(my / mx * tan(2.0 * PI * u.y)); // its values lie between -pi/2 and pi/2
    vec2 axis = vec2(cos(phi), sin(phi));
    vec2 scaled = axis / vec2(mx, my);
    float theta = atan(sqrt(-log(u.x) / dot(scaled, scaled)));
    vec3 h = vec3(sin(theta) * axis, cos(theta));
    vec3 wi = 2.0 * dot(wo, h) * h - wo;
    return DirectionSample(wi, direction_pdf(wo, wi));
}
