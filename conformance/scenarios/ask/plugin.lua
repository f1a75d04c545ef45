function TestCase.run()
  local picture = io.popen("mktemp -d"):read("l") .. "/hand.png"
  local file = assert(io.open(picture, "wb"))
  file:write("\x89PNG\r\n\x1a\n")
  file:close()
  local answer = rtf.ask("Is the hand\nclosed?", { "yes", "no" }, 20, "no", picture)
  rtf.report("answer: " .. answer)
  rtf.case("serial number", function()
    rtf.report("answer: " .. rtf.ask("Serial number?", nil, nil, "SN-17"))
  end)
  rtf.instruct("Push the button", nil, 1.5, "done")
  rtf.report("pushed")
end
