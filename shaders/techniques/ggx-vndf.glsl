/*---
provides = ["technique"]
name = "ggx-vndf"
title = "GGX visible normals"
source = "Heitz, Sampling the GGX Distribution of Visible Normals (2018)"
models = ["ggx"]
uses = ["mx", "my"]
below_horizon = true
---*/
#include "common/ggx-visible.glsl"

float direction_pdf(vec3 wo, vec3 wi) {
    return ggx_visible_density(wo, wi, 0.0, mx, my);
}

// A point of the projection of the hemisphere that wo, stretched, sees (Heitz's section 4): the unit disk, of which the lower
// half is squeezed onto the visible half ellipse. As printed, 1 - t1^2 - t2^2 and the height of the normal are differences;
// here both come from the distances of the point to the ends of its chord, whose product is 1 - u1.
DirectionSample sample_direction(vec3 wo, vec2 u) {
    vec3 view = ggx_stretched(wo, mx, my);
    float size = length(view);
    view /= size;
    vec2 direction = azimuth(view);
    float sine = dot(view.xy, direction);
    vec2 point = sqrt(u.x) * point_on_circle(u.y);
    float rest = 1.0 - u.x;
    float chord = sqrt(rest + point.y * point.y); // half its length
    float longer = chord + abs(point.y), shorter = rest / longer;
    float to_top = point.y > 0.0 ? shorter : longer, to_bottom = point.y > 0.0 ? longer : shorter;
    float share = 0.5 * (1.0 + view.z), squeeze = 0.5 * sine * sine / (1.0 + view.z); // share + squeeze = 1
    float t2 = squeeze * to_bottom + view.z * point.y;
    float t3 = sqrt(share * (share * rest + 2.0 * squeeze * chord * to_top));
    float height = t2 < 0.0
        ? share * to_bottom * (view.z * chord - t2) / (view.z * t3 - sine * t2)
        : sine * t2 + view.z * t3;
    vec3 normal = from_azimuth_frame(vec3(sine * t3 - view.z * t2, point.x, height), direction);
    // The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
    vec3 wi = ggx_reflection(wo, normal, size * t3, mx, my);
    return DirectionSample(wi, ggx_cap_density(wo, half_vector(wi, wo), 0.0, mx, my));
}
