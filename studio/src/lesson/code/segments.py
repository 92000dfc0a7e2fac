from chordal.shapes import bezier

arch = bezier([(1.5, 1.6), (2.2, 7.6), (8.2, 7.4), (10.6, 1.8)])
for n in (8, 16, 32):
    chain = arch.flatten(segments=n, spacing="even")
    print(n, "segments: at most", 60 * chain.bound.at_most, "pixels off")
