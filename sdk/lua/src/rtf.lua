-- The table `rtf` of a Lua plug-in. `host` contains the host's functions.
local host, near, text, guard, stop = ...

-- Taken before the plug-in can replace them.
local error, tostring = error, tostring

local POLL_SECONDS = 0.01

local rtf = {}

-- Sends a message with the line of the plug-in that called.
local function send(kind, message, comparison, critical)
  local file, line = guard.location(3)
  host.message(kind, tostring(message), file, line, comparison, critical)
end

-- Whether a critical assertion has failed: it ends the test, not only its case.
local is_critical = false

-- Ends the step, or the innermost case. The problem was reported before, so a pcall in the plug-in does not turn
-- a failure into a pass.
local function unwind()
  error(stop, 0)
end

function rtf.report(message)
  send("report", message)
end

function rtf.check(condition, message)
  send(condition and "check" or "failure", message)
  return not not condition
end

function rtf.require(condition, message)
  send(condition and "check" or "failure", message)
  if not condition then
    unwind()
  end
end

function rtf.require_critical(condition, message)
  send(condition and "check" or "failure", message, nil, not condition)
  if not condition then
    is_critical = true
    unwind()
  end
end

function rtf.fail(message)
  send("failure", message)
  unwind()
end

function rtf.error(message)
  send("error", message)
  unwind()
end

local function compare(got, expected, tolerance, what, is_angle)
  local good, comparison, problem = pcall(near.compare, got, expected, tolerance, is_angle)
  if not good then
    error(comparison, 4)
  end
  what = tostring(what)
  local file, line = guard.location(3)
  if problem then
    host.message("failure", ("%s: %s"):format(what, problem), file, line, comparison, false)
  else
    host.message("check", what, file, line, comparison, false)
  end
  return not problem
end

function rtf.check_near(got, expected, tolerance, what)
  local holds = compare(got, expected, tolerance, what, false)
  return holds
end

function rtf.check_angle_near(got, expected, tolerance, what)
  local holds = compare(got, expected, tolerance, what, true)
  return holds
end

function rtf.require_near(got, expected, tolerance, what)
  if not compare(got, expected, tolerance, what, false) then
    unwind()
  end
end

function rtf.require_angle_near(got, expected, tolerance, what)
  if not compare(got, expected, tolerance, what, true) then
    unwind()
  end
end

local function number_or_nil(value, what, level)
  if value ~= nil and (not math.type(value) or value ~= value) then
    error(("%s is not a number: %s"):format(what, tostring(value)), level or 3)
  end
end

function rtf.measure(name, value, unit, low, high)
  if not math.type(value) then
    error(("the value of `%s` is not a number: %s"):format(tostring(name), tostring(value)), 2)
  end
  number_or_nil(low, "the lower limit")
  number_or_nil(high, "the upper limit")
  local file, line = guard.location(2)
  unit = unit == nil and "" or tostring(unit)
  return host.measure(tostring(name), value, unit, low, high, file, line)
end

-- Takes a sample for a function that the plug-in called.
local function sample(name, value, unit, low, high, time)
  if not math.type(value) then
    error(("the value of `%s` is not a number: %s"):format(tostring(name), tostring(value)), 3)
  end
  number_or_nil(low, "the lower limit", 4)
  number_or_nil(high, "the upper limit", 4)
  if time ~= nil and (not math.type(time) or time - time ~= 0) then
    error(("the time of a sample is not a finite number: %s"):format(tostring(time)), 3)
  end
  local file, line = guard.location(3)
  unit = unit == nil and "" or tostring(unit)
  return host.sample(tostring(name), value, unit, low, high, time, file, line)
end

function rtf.sample(name, value, unit, low, high, time)
  local within = sample(name, value, unit, low, high, time)
  return within
end

function rtf.monitor(formula, name, severity)
  local file, line = guard.location(2)
  name = name == nil and "" or tostring(name)
  severity = severity == nil and "" or tostring(severity)
  local problem = host.monitor(tostring(formula), name, severity, file, line)
  if problem then
    error(problem, 2)
  end
end

-- Sleeps by the wall clock.
local function pause(seconds)
  if host.wait(seconds) then
    unwind()
  end
end

-- Returns a function that returns the elapsed time, without jumps back.
local function stopwatch()
  local before, passed = host.seconds(), 0
  return function()
    local seconds = host.seconds()
    if seconds then
      passed = passed + math.max(0, seconds - (before or seconds))
      before = seconds
    end
    return passed
  end
end

local latest = 0.0

function rtf.now()
  latest = host.seconds() or latest
  return latest
end

-- Sleeps by the suite's clock.
local function sleep(seconds)
  if not host.is_simulated() then
    pause(seconds)
    return
  end
  local watch = stopwatch()
  local left = seconds
  repeat
    pause(math.min(POLL_SECONDS, left))
    left = seconds - watch()
  until left <= 0
end

function rtf.sample_for(name, seconds, rate, read, unit, low, high)
  if not math.type(seconds) or not math.type(rate) or not (rate > 0) then
    error(("sample_for takes seconds and a rate in Hz, not %s and %s"):format(tostring(seconds),
      tostring(rate)), 2)
  end
  local watch, all_within, tick = stopwatch(), true, 0
  while tick < seconds * rate - 1e-9 do
    sleep(tick / rate - watch())
    local within = sample(name, read(), unit, low, high)
    all_within = within and all_within
    -- A slow reading skips samples.
    tick = math.max(tick + 1, math.ceil(watch() * rate))
  end
  sleep(seconds - watch())
  return all_within
end

-- The parameters of a case as pairs, by name.
local function pairs_of(parameters)
  local all = {}
  for name, value in pairs(parameters) do
    all[#all + 1] = { tostring(name), text.value(value) }
  end
  table.sort(all, function(a, b) return a[1] < b[1] end)
  return all
end

function rtf.case(name, parameters, body)
  if body == nil then
    parameters, body = {}, parameters
  end
  if type(parameters) ~= "table" or type(body) ~= "function" then
    error("case takes a name, a table of parameters that can be omitted, and a function", 2)
  end
  local file, line = guard.location(2)
  if not host.case_begin(tostring(name), pairs_of(parameters), file, line) then
    return
  end
  local ended, problem, problem_file, problem_line = guard.call(body)
  if ended == "broken" then
    host.message("error", problem, problem_file, problem_line, nil, false)
  end
  host.case_end(ended == "done")
  if ended ~= "done" and (is_critical or host.interrupted()) then
    unwind()
  end
end

function rtf.skip(reason)
  host.skip(tostring(reason))
  unwind()
end

function rtf.plan_cases(names)
  if type(names) ~= "table" then
    error(("plan_cases takes a table of names, not %s"):format(tostring(names)), 2)
  end
  local planned = {}
  for index, name in ipairs(names) do
    planned[index] = tostring(name)
  end
  host.plan_cases(planned)
end

-- Returns the value of a pair with this name. The error for an unknown name:
-- there is no <what> "…"; <known_are> a, b
local function find(values, name, what, known_are)
  local known = {}
  for index, pair in ipairs(values) do
    if pair[1] == name then
      return pair[2]
    end
    known[index] = pair[1]
  end
  local list = #known > 0 and table.concat(known, ", ") or "none"
  local file, line = guard.location(3)
  local problem = ('there is no %s "%s"; %s %s'):format(what, tostring(name), known_are, list)
  host.message("error", problem, file, line, nil, false)
  unwind()
end

function rtf.parameter(name)
  local value = find(host.plugin.parameters, name, "parameter", "this test has")
  return value
end

function rtf.parameters()
  local all = {}
  for _, parameter in ipairs(host.plugin.parameters) do
    all[parameter[1]] = parameter[2]
  end
  return all
end

function rtf.provide(name, value)
  local problem = host.provide(tostring(name), value)
  if problem then
    error(problem, 2)
  end
end

local function copy(value)
  if type(value) ~= "table" then
    return value
  end
  local copied = {}
  for key, entry in pairs(value) do
    copied[key] = copy(entry)
  end
  return copied
end

-- Each call returns a new table, so that a plug-in can change it.
function rtf.fixture_value(name)
  local value = find(host.plugin.fixture_values, name, "fixture value", "there are")
  return copy(value)
end

function rtf.check_trajectory(name, reference, tolerance, align, band)
  if type(tolerance) ~= "number" then
    error(("the tolerance of a trajectory is a number, not %s"):format(tostring(tolerance)), 2)
  end
  align = align or "time"
  if align ~= "time" and align ~= "dtw" then
    error(('align is "%s", expected "time" or "dtw"'):format(tostring(align)), 2)
  end
  local file, line = guard.location(2)
  host.trajectory(tostring(name), tostring(reference), tolerance, align == "dtw", band, file, line)
end

function rtf.check_picture(name, picture, reference, tolerance)
  if type(tolerance) ~= "number" then
    error(("the tolerance of a picture is a number, not %s"):format(tostring(tolerance)), 2)
  end
  local file, line = guard.location(2)
  local problem =
    host.picture(tostring(name), tostring(picture), tostring(reference), tolerance, file, line)
  if problem then
    error(problem, 2)
  end
end

function rtf.attach(path, name, media_type)
  local problem = host.attach(tostring(path), name and tostring(name), media_type and tostring(media_type))
  if problem then
    error(problem, 2)
  end
end

function rtf.sleep(seconds)
  if not math.type(seconds) then
    error(("sleep takes seconds, not %s"):format(tostring(seconds)), 2)
  end
  sleep(seconds)
end

function rtf.wait_until(condition, timeout, what)
  if not math.type(timeout) then
    error(("wait_until takes its time in seconds, not %s"):format(tostring(timeout)), 2)
  end
  local watch = stopwatch()
  while true do
    local value = condition()
    if value then
      return true
    end
    local left = timeout - watch()
    if left <= 0 then
      local whose = host.is_simulated() and " of simulated time" or ""
      send("failure", ("%s: not within %s s%s (last value: %s)"):format(tostring(what),
        text.number(timeout), whose, text.value(value)))
      unwind()
    end
    pause(math.min(POLL_SECONDS, left))
  end
end

-- How long a question waits for an answer.
local ANSWER_SECONDS = 300

-- Asks an operator for a function that the plug-in called.
local function ask(what, choices, timeout, default, picture)
  timeout = timeout == nil and ANSWER_SECONDS or timeout
  if not math.type(timeout) then
    error(("the timeout of a question is not a number of seconds: %s"):format(tostring(timeout)), 3)
  end
  local file, line = guard.location(3)
  local answer = host.ask(tostring(what), choices, timeout, default and tostring(default),
    picture and tostring(picture), file, line)
  if answer == nil then
    unwind()
  end
  return answer, file, line
end

function rtf.ask(question, choices, timeout, default, picture)
  choices = choices == nil and {} or choices
  if type(choices) ~= "table" then
    error(("the choices of a question are not a table: %s"):format(tostring(choices)), 2)
  end
  local texts = {}
  for index, choice in ipairs(choices) do
    texts[index] = tostring(choice)
  end
  local answer = ask(question, texts, timeout, default, picture)
  return answer
end

function rtf.instruct(what, picture, timeout, default)
  local answer, file, line = ask(what, { "done", "cannot" }, timeout, default, picture)
  if answer ~= "done" then
    host.message("error", "the operator cannot do this: " .. tostring(what), file, line, nil, false)
    unwind()
  end
end

rtf.interrupted = host.interrupted

function rtf.collapsed(reason)
  host.collapsed(tostring(reason))
end

for _, name in ipairs({ "name", "param", "environment", "repetition" }) do
  rtf[name] = function()
    return host.plugin[name]
  end
end

return rtf
