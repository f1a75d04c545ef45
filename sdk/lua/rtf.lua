---@meta
-- The functions for plug-ins of the Robot Testing Framework, for the Lua language
-- server: add this directory to `workspace.library`. Plug-ins do not load this file: the
-- host provides `rtf`.

---A number, a vector, or a matrix row by row.
---@alias rtf.Numbers number | number[] | number[][]

---Fill in the functions of your test: `function TestCase.run() … end`.
---@class rtf.TestCase
---@field setup? fun(args: string[]): boolean? Prepares the test; only `false` means that it failed.
---@field run fun() Runs the test.
---@field tearDown? fun() Restores the initial state. Always called.
TestCase = {}

---Fill in the functions of your fixture: `function FixtureManager.setup(args) … end`.
---@class rtf.FixtureManager
---@field setup? fun(args: string[]): boolean? Starts the fixture; only `false` means that it failed.
---@field check? fun(): boolean? Checks the fixture; `false` means that it collapsed.
---@field tearDown? fun() Stops the fixture, also after a failed set-up.
FixtureManager = {}

rtf = {}

---Reports information; it does not change the verdict.
---@param text any
function rtf.report(text) end

---Checks that the condition holds, and continues in either case.
---@param condition any
---@param text any
---@return boolean holds
function rtf.check(condition, text) end

---Asserts that the condition holds; if it does not, the step ends.
---@param condition any
---@param text any
function rtf.require(condition, text) end

---Asserts that it is safe to continue: if not, the rest of the suite is skipped.
---@param condition any
---@param text any
function rtf.require_critical(condition, text) end

---Reports a failure (the robot is wrong) and ends the step.
---@param text any
function rtf.fail(text) end

---Reports an error (the bench is wrong: no network, no calibration) and ends the step.
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

---Waits until the condition is true, polling every 10 ms. After the timeout, the
---assertion fails with `what` and the last value.
---@param condition fun(): any
---@param timeout number Seconds.
---@param what any
---@return true
function rtf.wait_until(condition, timeout, what) end

---Records a number; outside its limits it is a failure.
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
---@param time? number Seconds since the test's set-up began; the default is the current time.
---@return boolean within
function rtf.sample(name, value, unit, low, high, time) end

---Samples the result of `read` for `seconds` at `rate` Hz. A slow `read` skips
---samples.
---@param name string
---@param seconds number
---@param rate number
---@param read fun(): number
---@param unit? string
---@param low? number
---@param high? number
---@return boolean within Whether all samples were.
function rtf.sample_for(name, seconds, rate, read, unit, low, high) end

---Asks an operator, on the console, the page or the API, and returns the answer: one of the
---choices, or without them any line of text. If no operator answers in time, or none can, it is the
---default; without a default, this is an error.
---@param question any
---@param choices? any[]
---@param timeout? number Seconds; the default is 300.
---@param default? any
---@param picture? string The path of a PNG or JPEG file.
---@return string answer
function rtf.ask(question, choices, timeout, default, picture) end

---Gives an operator an instruction, and waits until it is done. The answers are `done` and `cannot`,
---which is an error; the default is one of them.
---@param text any
---@param picture? string The path of a PNG or JPEG file.
---@param timeout? number Seconds; the default is 300.
---@param default? string
function rtf.instruct(text, picture, timeout, default) end

---Judges the rest of the test by a formula over the signals of the suite.
---@param formula string
---@param name? string The default is the formula.
---@param severity? "fail"|"error"|"stop"|"critical" What a violation means; the default is "fail".
function rtf.monitor(formula, name, severity) end

---Runs the body as a case: a named result of the test. An assertion, an error or `skip` ends
---the case, and the test continues after it.
---@param name any
---@param parameters table<any, any> Can be omitted.
---@param body fun()
---@overload fun(name: any, body: fun())
function rtf.case(name, parameters, body) end

---Ends the case, or without one the test, as skipped. Allowed in `setup` and `run`.
---@param reason any
function rtf.skip(reason) end

---Announces top-level cases: reports show which of them did not run, and a test that would
---pass without having run them all is an error.
---@param names any[]
function rtf.plan_cases(names) end

---The test's value of a matrix. An unknown name is an error.
---@param name string
---@return string
function rtf.parameter(name) end

---All values of the matrix.
---@return table<string, string>
function rtf.parameters() end

---A string, a number, a boolean, or a table of these. Numbers must be finite. A table is
---either a list without holes, or has only strings as keys; an empty table is an empty object.
---@alias rtf.Value string | number | boolean | table<string, rtf.Value> | rtf.Value[]

---Provides a value of the fixture for tests, hooks and dependent fixtures. Allowed in `setup`,
---once for each name. An integer stays an integer.
---@param name string
---@param value rtf.Value
function rtf.provide(name, value) end

---A value that a fixture provided: `rtf.fixture_value("simulator.port")`. An unknown name is an
---error. A fixture sees the values of the fixtures that it depends on. A JSON `null` inside a
---value is `nil`; an integer that Lua cannot represent is a float.
---@param name string
---@return rtf.Value
function rtf.fixture_value(name) end

---Checks that a signal, as sampled so far, stays within `tolerance` of a stored trajectory, which
---`rtf golden accept` writes. The runner compares: the test continues, and a deviation is a failure.
---@param name string The signal.
---@param reference string A file below the directory of the suite.
---@param tolerance number In the unit of the signal.
---@param align? "time"|"dtw" By time, or by dynamic time warping.
---@param band? number By how many seconds times may differ with "dtw".
function rtf.check_trajectory(name, reference, tolerance, align, band) end

---A fault that the test has injected. It ends with the test at the latest.
---@class rtf.Fault
---@field name string
local Fault = {}

---Removes it. No effect if it has ended already.
function Fault:remove() end

---Injects a fault of the suite that has no `at`, and returns when it has begun. With `local lost <close> =
---rtf.fault("drop")`, it is removed at the end of the block.
---@param name string
---@return rtf.Fault
function rtf.fault(name) end

---Checks that a picture differs by at most `tolerance` from a stored one, which `rtf golden accept`
---writes. The runner compares: the test continues, and a difference is a failure.
---@param name string The name of the attachment.
---@param picture string A PNG or JPEG file, which is copied.
---@param reference string A file below the directory of the suite.
---@param tolerance number 1 minus the structural similarity, at least 0.
function rtf.check_picture(name, picture, reference, tolerance) end

---Adds a copy of a complete file to the results. The file may be deleted afterwards.
---@param path string
---@param name? string The default is the file's name.
---@param media_type? string
function rtf.attach(path, name, media_type) end

---Seconds since an arbitrary time, by the suite's clock.
---@return number
function rtf.now() end

---Sleeps by the suite's clock. A stop request ends the sleep and the step.
---@param seconds number
function rtf.sleep(seconds) end

---Whether the runner has asked to stop; long loops should poll this.
---@return boolean
function rtf.interrupted() end

---Reports that the fixture collapsed.
---@param reason any
function rtf.collapsed(reason) end

---The plug-in's name in the suite.
---@return string
function rtf.name() end

---The plug-in's parameter string in the suite.
---@return string
function rtf.param() end

---The suite's environment string.
---@return string
function rtf.environment() end

---The present repetition, from 1.
---@return integer
function rtf.repetition() end

return rtf
