//! The syntax tree, prepared for evaluation: comparisons are numbered, and each part of the formula
//! knows where its function begins.

use crate::comparison::Comparison;
use crate::expression::Expression;
use crate::syntax::{Comparison as Sign, Condition, Interval, Quantifier, Tense};

/// A part of the formula.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    /// A comparison, by its index.
    Atom(usize),
    /// `inf` or `-inf`.
    Constant(f64),
    Not(Box<Node>),
    Junction(Quantifier, Vec<Node>),
    Window(Temporal, Quantifier, Box<Node>),
    UpTo(Temporal, Box<[Node; 2]>),
    /// An edge: the first condition is true after a time, the second one is false before it. They
    /// are the same, but of opposite polarity.
    Edge(Box<[Node; 2]>),
}

/// What temporal operators have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Temporal {
    pub tense: Tense,
    pub interval: Interval,
    /// 1, or -1 if it is negated as a part of the formula.
    pub polarity: f64,
    /// The index of the value that an unbounded operator of the past had at the start of what is
    /// kept.
    pub memory: Option<usize>,
}

impl Node {
    /// How long after a time samples are necessary. An unbounded operator of the future does not
    /// count, apart from the start of its interval.
    pub(crate) fn horizon(&self) -> f64 {
        let longest = |nodes: &[Node]| nodes.iter().map(Node::horizon).fold(0.0, f64::max);
        match self {
            Self::Atom(_) | Self::Constant(_) => 0.0,
            Self::Not(inner) => inner.horizon(),
            Self::Junction(_, parts) => longest(parts),
            Self::Edge(parts) => longest(parts.as_slice()),
            Self::Window(temporal, _, inner) => temporal.horizon() + inner.horizon(),
            Self::UpTo(temporal, sides) => temporal.horizon() + longest(sides.as_slice()),
        }
    }

    /// Whether it has an unbounded operator of the future.
    pub(crate) fn is_unbounded(&self) -> bool {
        match self {
            Self::Atom(_) | Self::Constant(_) => false,
            Self::Not(inner) => inner.is_unbounded(),
            Self::Junction(_, parts) => parts.iter().any(Self::is_unbounded),
            Self::Edge(parts) => parts.iter().any(Self::is_unbounded),
            Self::Window(temporal, _, inner) => temporal.is_unbounded() || inner.is_unbounded(),
            Self::UpTo(temporal, sides) => {
                temporal.is_unbounded() || sides.iter().any(Self::is_unbounded)
            }
        }
    }
}

impl Temporal {
    fn horizon(&self) -> f64 {
        let Interval { from, to } = self.interval;
        match self.tense {
            Tense::Past => 0.0,
            Tense::Future if to.is_finite() => to,
            Tense::Future => from,
        }
    }

    /// Whether it looks into the future without a bound.
    pub(crate) fn is_unbounded(&self) -> bool {
        self.tense == Tense::Future && self.interval.to.is_infinite()
    }
}

/// A formula or a part of it, and its comparisons.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub node: Node,
    pub comparisons: Vec<Comparison>,
    /// How many values of the past are stored.
    pub memories: usize,
    /// For each comparison, when its function begins, in seconds after the start of what is
    /// evaluated.
    pub shifts: Vec<f64>,
    /// How long before a time samples matter, apart from stored values.
    pub reach: f64,
}

impl Program {
    /// Prepares a condition; the polarity is -1 if it is negated as a part of the formula.
    pub(crate) fn new(condition: &Condition, polarity: f64) -> Self {
        let mut program = Self {
            node: Node::Constant(0.0),
            comparisons: Vec::new(),
            memories: 0,
            shifts: Vec::new(),
            reach: 0.0,
        };
        program.node = program.compile(condition, polarity, 0.0);
        program
    }

    /// Compiles a part whose function begins `shift` seconds after the start.
    fn compile(&mut self, condition: &Condition, polarity: f64, shift: f64) -> Node {
        self.reach = self.reach.max(-shift);
        match condition {
            Condition::Constant(value, _) => {
                Node::Constant(if *value { f64::INFINITY } else { f64::NEG_INFINITY })
            }
            Condition::Comparison { comparison, sides, span } => {
                let mut leaves = Vec::new();
                let expression = Expression::difference(*comparison, sides, &mut leaves);
                let sign = *comparison;
                let span = span.clone();
                let atom = Comparison { expression, leaves, sign, is_truth: false, polarity, span };
                self.atom(atom, shift)
            }
            Condition::Truth { index, span } => {
                let mut leaves = Vec::new();
                let expression = Expression::truth(*index, &mut leaves);
                let span = span.clone();
                let sign = Sign::Greater;
                let atom = Comparison { expression, leaves, sign, is_truth: true, polarity, span };
                self.atom(atom, shift)
            }
            Condition::Not(inner, _) => Node::Not(Box::new(self.compile(inner, -polarity, shift))),
            Condition::Junction { quantifier, parts, .. } => {
                let parts = parts.iter().map(|part| self.compile(part, polarity, shift)).collect();
                Node::Junction(*quantifier, parts)
            }
            Condition::Window { tense, quantifier, interval, inner, .. } => {
                let (temporal, shift) = self.temporal(*tense, *interval, polarity, shift);
                let inner = self.compile(inner, polarity, shift);
                Node::Window(temporal, *quantifier, Box::new(inner))
            }
            Condition::UpTo { tense, interval, sides, .. } => {
                let begin = if *tense == Tense::Future { 0.0 } else { interval.from };
                let interval_of_sides = Interval { from: begin, ..*interval };
                let (mut temporal, shift) =
                    self.temporal(*tense, interval_of_sides, polarity, shift);
                temporal.interval = *interval;
                let [left, right] = sides.as_ref();
                let left = self.compile(left, polarity, shift);
                let right = self.compile(right, polarity, shift);
                Node::UpTo(temporal, Box::new([left, right]))
            }
            Condition::Edge { rises, inner, .. } => self.edge(*rises, inner, polarity, shift),
        }
    }

    fn edge(&mut self, rises: bool, inner: &Condition, polarity: f64, shift: f64) -> Node {
        let mut side = |polarity: f64| {
            if rises {
                return self.compile(inner, polarity, shift);
            }
            Node::Not(Box::new(self.compile(inner, -polarity, shift)))
        };
        Node::Edge(Box::new([side(polarity), side(-polarity)]))
    }

    /// An operator, and where its operands begin.
    fn temporal(
        &mut self,
        tense: Tense,
        interval: Interval,
        polarity: f64,
        shift: f64,
    ) -> (Temporal, f64) {
        let mut memory = None;
        let shift = match tense {
            Tense::Future => shift + interval.from,
            Tense::Past if interval.to.is_finite() => shift - interval.to,
            Tense::Past => {
                let shift = shift - interval.from;
                memory = Some(self.memories);
                self.memories += 1;
                shift
            }
        };
        (Temporal { tense, interval, polarity, memory }, shift)
    }

    fn atom(&mut self, atom: Comparison, shift: f64) -> Node {
        self.comparisons.push(atom);
        self.shifts.push(shift);
        Node::Atom(self.comparisons.len() - 1)
    }
}
