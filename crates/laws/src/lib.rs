//! One closed-form physical law per file: pure functions, few scalars in, few out.
