---@meta
-- What a plug-in of the Robot Testing Framework may call, for the Lua language
-- server: name this folder in `workspace.library`. It is never loaded by a
-- plug-in: the host brings `rtf` with it.

---A number, a vector, or a matrix row by row.
---@alias rtf.Numbers number | number[] | number[][]

---Fill in the functions of your test: `function TestCase.run() … end`.
---@class rtf.TestCase
---@field setup? fun(args: string[]): boolean? Prepares the test; only `false` fails.
---@field run fun() Does the test.
---@field tearDown? fun() Puts back what the test changed. Called whatever happened before.
TestCase = {}

---Fill in the functions of your fixture: `function FixtureManager.setup(args) … end`.
---@class rtf.FixtureManager
---@field setup? fun(args: string[]): boolean? Brings the fixture up; only `false` fails.
---@field check? fun(): boolean? Whether it is well; `false` means that it collapsed.
---@field tearDown? fun() Brings it down, also after a set-up that failed.
FixtureManager = {}

rtf = {}

---Tells the user something; it does not change the verdict.
---@param text any
function rtf.report(text) end

---Checks that the condition holds, and goes on either way.
---@param condition any
---@param text any
---@return boolean holds
function rtf.check(condition, text) end

---Asserts that the condition holds; if it does not, the step ends.
---@param condition any
---@param text any
function rtf.require(condition, text) end

---Asserts something without which it is unsafe to go on: if it does not hold,
---the rest of the suite is skipped.
---@param condition any
---@param text any
function rtf.require_critical(condition, text) end

---Says that the robot is wrong, and ends the step.
---@param text any
function rtf.fail(text) end

---Says that the bench is wrong (no network, no calibration file), and ends the step.
---@param text any
function rtf.error(text) end

---Checks that two numbers, vectors or matrices differ by at most `tolerance` anywhere.
---@param got rtf.Numbers
---@param expected rtf.Numbers
---@param tolerance number
---@param what any
---@return boolean holds
function rtf.check_near(got, expected, tolerance, what) end

---Asserts what `check_near` checks.
---@param got rtf.Numbers
---@param expected rtf.Numbers
---@param tolerance number
---@param what any
function rtf.require_near(got, expected, tolerance, what) end

---Checks angles in radians: 3.1 and -3.1 are 0.083 apart.
---@param got rtf.Numbers
---@param expected rtf.Numbers
---@param tolerance number
---@param what any
---@return boolean holds
function rtf.check_angle_near(got, expected, tolerance, what) end

---Asserts what `check_angle_near` checks.
---@param got rtf.Numbers
---@param expected rtf.Numbers
---@param tolerance number
---@param what any
function rtf.require_angle_near(got, expected, tolerance, what) end

---Waits until the condition is true, asking every 10 ms. When the time is over
---this is a failed assertion, which tells the last value.
---@param condition fun(): any
---@param timeout number Seconds.
---@param what any
---@return true
function rtf.wait_until(condition, timeout, what) end

---Keeps a number with the result; outside its limits it is a failure.
---@param name string
---@param value number
---@param unit? string
---@param low? number
---@param high? number
---@return boolean within
function rtf.measure(name, value, unit, low, high) end

---Takes a sample of a signal; outside its limits it is a failure.
---@param name string
---@param value number
---@param unit? string
---@param low? number
---@param high? number
---@param time? number Seconds since the test's set-up began; now unless told.
---@return boolean within
function rtf.sample(name, value, unit, low, high, time) end

---Samples what `read` returns, for `seconds` at `rate` Hz. What a reading that
---takes too long misses is left out.
---@param name string
---@param seconds number
---@param rate number
---@param read fun(): number
---@param unit? string
---@param low? number
---@param high? number
---@return boolean within Whether all were.
function rtf.sample_for(name, seconds, rate, read, unit, low, high) end

---Keeps a copy of a file with the result. Write it to its end before; it may go
---afterwards.
---@param path string
---@param name? string The file's own name unless told.
---@param media_type? string
function rtf.attach(path, name, media_type) end

---Seconds since a moment that does not matter, by the clock that the suite has.
---@return number
function rtf.now() end

---Sleeps, in a suite with a clock by that one, but wakes at once when the runner asks to stop; then the step ends.
---@param seconds number
function rtf.sleep(seconds) end

---Whether the runner has asked to stop; a loop that runs long should look at it.
---@return boolean
function rtf.interrupted() end

---Tells at once that the fixture is not well any more.
---@param reason any
function rtf.collapsed(reason) end

---The name under which the suite knows this plug-in.
---@return string
function rtf.name() end

---The parameter string as it stands in the suite.
---@return string
function rtf.param() end

---The suite's environment string.
---@return string
function rtf.environment() end

---The repetition that runs, from 1.
---@return integer
function rtf.repetition() end

return rtf
