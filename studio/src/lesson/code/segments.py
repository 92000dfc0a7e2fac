from chordal.shapes import bezier

spout = bezier([(1.7, 0.6), (3.1, 0.825), (2.4, 2.025), (3.3, 2.4)])
for n in (8, 16, 32):
    chain = spout.flatten(segments=n, spacing="even")
    print(n, "segments: at most", 192 * chain.bound.at_most, "pixels off")
