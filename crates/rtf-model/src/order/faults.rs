//! Injected faults: one that lasts is removed at most once, and not injected again before.

use super::{OrderChecker, Rule, ensure};
use crate::{FaultInjected, TestId};

impl OrderChecker {
    pub(super) fn inject_fault(&mut self, fault: &FaultInjected) -> Rule {
        self.inside_test(fault.test)?;
        if fault.kind.lasts() {
            let is_new = self.test(fault.test)?.faults.insert(fault.name.clone());
            ensure(is_new, || format!("the fault `{}` lasts already", fault.name))?;
        }
        Ok(())
    }

    pub(super) fn remove_fault(&mut self, test: TestId, name: &str) -> Rule {
        self.inside_test(test)?;
        let lasts = self.test(test)?.faults.remove(name);
        ensure(lasts, || format!("the fault `{name}` of test {test} was not injected"))
    }
}
