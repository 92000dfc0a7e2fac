// What imports of other files than modules are. The modules are written by plugins in scripts/.
declare module "*.bpt?patch=16" {
  /** The control points of a patch, row by row. */
  const rows: readonly (readonly (readonly [x: number, y: number, z: number])[])[];
  export default rows;
}
