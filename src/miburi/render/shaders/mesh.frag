#version 330 core
// Matte, with a soft highlight; a key light from the upper left and a fill light from the right stand with the camera.
// What has no normals (the grid) is drawn in its plain colour.
in vec3 seen_position;
in vec3 colour;
#ifdef NORMAL_LOC
in vec3 seen_normal;
const vec3 key = vec3(-0.383, 0.613, 0.690);
const vec3 fill = vec3(0.870, 0.097, 0.483);
#endif
out vec4 frag_color;

void main()
{
#ifdef NORMAL_LOC
    vec3 n = normalize(seen_normal);
    vec3 halfway = normalize(key - normalize(seen_position));
    float light = 0.50 + 0.55 * max(dot(n, key), 0.0) + 0.18 * max(dot(n, fill), 0.0);
    float shine = max(dot(n, halfway), 0.0);
    shine *= shine;
    shine *= shine;
    shine *= shine;
    shine *= shine;
    frag_color = vec4(min(colour * light + 0.13 * shine, 1.0), 1.0);
#else
    frag_color = vec4(colour, 1.0);
#endif
}
