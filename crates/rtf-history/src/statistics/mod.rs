//! Statistics of series of results. Pure functions: no store, no clock.
