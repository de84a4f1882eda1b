mod cosines;
mod equality;
mod estimates;
mod hard_cases;
mod leaves;
mod paper;
mod patterns;
mod truths;
