//! How a time step passes positions in which the constraints of ideal joints are dependent.

/// State at one end of a step.
#[derive(Debug, Clone, Copy)]
pub struct State<'a> {
    /// Time of the state [s].
    pub time: f64,
    /// Positions `(n,)` [m, rad].
    pub q: &'a [f64],
    /// Velocities `(n,)` [m/s, rad/s].
    pub v: &'a [f64],
    /// Force with reactions `(n,)` [N, N m]; `None` if it is not known.
    pub f: Option<&'a [f64]>,
}

/// How a step passes such positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Passing {
    /// There is none.
    Clear,
    /// Through one, on the one branch of the motion.
    Through,
    /// The step is too long, or ends too near, to tell.
    Unclear,
    /// The motion branches there.
    Branching,
}
