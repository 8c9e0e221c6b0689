// Reflection at the facets of the GGX distribution that the view sees.
// Source: Heitz, "Sampling the GGX Distribution of Visible Normals" (2018); Dupuy and Benyoub, "Sampling Visible GGX Normals
// with Spherical Caps" (2023); Eto and Tokuyoshi, "Bounded VNDF Sampling for Smith-GGX Reflections" (2023).
#ifndef SAMPLERSCOPE_GGX_VISIBLE
#define SAMPLERSCOPE_GGX_VISIBLE

#include "common/frame.glsl"
#include "common/ggx.glsl"

// In the stretched space, where facets are mirrors on a sphere, reflected directions fill evenly the cap z > -z of wo:
// Dupuy and Benyoub. `spared` is the part of the cap's depth z of wo that is cut off: 0 leaves all visible normals.

// Density of wi in the cap, D G1/(4 co) over the share of the cap that is left. Directions below the horizon are some of them.
float ggx_cap_density(vec3 wo, HalfVector h, float spared, float mx, float my) {
    return 0.5 * ggx_distribution(h, mx, my) / (length(ggx_stretched(wo, mx, my)) + (1.0 - spared) * wo.z);
}

// The same, 0 beyond the rim of the cap. All above the horizon lies in it, and no rounding may take any out.
float ggx_visible_density(vec3 wo, vec3 wi, float spared, float mx, float my) {
    HalfVector h = half_vector(wi, wo);
    bool drawn = wi.z >= 0.0 || (wi.z + wo.z) * ggx_squared_stretch(h, mx, my) > spared * wo.z;
    return drawn ? ggx_cap_density(wo, h, spared, mx, my) : 0.0;
}

// The mirror image of wo about a normal n of the stretched space, of any length. `facing` is the product of n with wo
// stretched, which samplers know by construction; as a sum it cancels at grazing views.
vec3 ggx_reflection(vec3 wo, vec3 n, float facing, float mx, float my) {
    vec3 h = ggx_stretched(n, mx, my);
    return 2.0 * facing / dot(h, h) * h - wo;
}

// Reflection at the half vector that joins wo, stretched, to an even point of the cap, its azimuth counted from wo. What is
// small at the rim behind wo, where the two cancel, is made of products: heights over the rim and squared sines of sums of
// positive terms, the sum of both directions of half the angle between them.
DirectionSample ggx_cap_sample(vec3 wo, vec2 u, float spared, float mx, float my) {
    vec3 view = ggx_stretched(wo, mx, my);
    float size = length(view);
    view /= size;
    vec2 direction = azimuth(view);
    float view_sine = dot(view.xy, direction);
    float depth = (1.0 - spared) * view.z;
    float from_top = u.x * (1.0 + depth), view_from_top = view_sine * view_sine / (1.0 + view.z); // 1 less the height
    float height = (1.0 - u.x) * (1.0 + depth) + spared * view.z; // of the point over -view
    float sine = sqrt(from_top * (height + view_from_top));
    float excess = (view_from_top - from_top) * height / max(view_sine + sine, 1.0e-30); // view_sine - sine
    vec2 half_turn = point_on_circle(0.5 * u.y);
    vec3 h = vec3(2.0 * sine * half_turn.x * half_turn + vec2(excess, 0.0), height);
    vec3 wi = ggx_reflection(wo, from_azimuth_frame(h, direction), 0.5 * size * dot(h, h), mx, my);
    // The density is taken at the rounded direction, where the model is evaluated too: what both share cancels.
    return DirectionSample(wi, ggx_cap_density(wo, half_vector(wi, wo), spared, mx, my));
}

#endif
