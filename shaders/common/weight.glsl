// The throughput weight of a drawn direction: f cos / pdf, 0 where the density is 0 or wi is below the horizon.
// A NaN or infinite density or direction is not laundered: it stays in the sample, where the caller looks for it.
float throughput_weight(DirectionSample s, vec3 wo) {
    bool counts = s.pdf > 0.0 && (!HORIZON_TEST || s.wi.z > 0.0);
    return counts ? model_brdf(s.wi, wo) * s.wi.z / s.pdf : 0.0;
}
