//! velomotion
