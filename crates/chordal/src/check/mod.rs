//! The judge: measures and proves, builds nothing.
