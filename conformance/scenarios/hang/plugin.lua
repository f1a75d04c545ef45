-- Never comes back, and catches the error by which the host ends a busy loop.
local function busy()
  while true do
  end
end

function TestCase.run()
  rtf.report("going to hang")
  while true do
    pcall(busy)
  end
end
