// The header from C++: that it compiles without warnings, and that the names link.
#include <peel.h>

#include <cstdio>

int main()
{
    PeelArithmetic driver = {};
    PeelEquation under = {};
    const float source[4] = {0.25f, 0.5f, 0.75f, 0.5f};
    unsigned char pixel[4] = {0, 0, 0, 255};
    if (peel_arithmetic_parse("driver", &driver) != PEEL_OK ||
        peel_equation_parse("under", &under) != PEEL_OK ||
        peel_blend(&driver, &under, PEEL_RGBA8, 1, source, pixel) != PEEL_OK) {
        std::fprintf(stderr, "%s\n", peel_message());
        return 1;
    }
    std::printf("C++, under, rgba8, driver: %d %d %d %d\n", pixel[0], pixel[1], pixel[2], pixel[3]);
    return pixel[0] == 64 && pixel[1] == 128 && pixel[2] == 191 && pixel[3] == 127 ? 0 : 1;
}
