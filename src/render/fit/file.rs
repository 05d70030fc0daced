//! The file with limits.

use crate::workflow::fit::LimitsFile;

/// What people should know who open it.
const HEAD: &str = "# What a machine does with what it is sent, as `hydrotrace fit` found it in logs; for
# `hydrotrace replan --limits`. Radians and seconds. A quantity has a value and its 95 % interval, or
# the lower_bound that was reached; identified = false: the logs do not decide it. Pairs are for
# growing and for shrinking angles; inf: no limit showed.
";

/// A fit as a file that `replan` reads.
///
/// # Errors
///
/// A number that TOML cannot hold.
pub fn limits_toml(file: &LimitsFile) -> Result<String, toml::ser::Error> {
    Ok(format!("{HEAD}{}", toml::to_string(file)?))
}
