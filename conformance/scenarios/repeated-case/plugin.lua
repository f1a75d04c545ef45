function TestCase.run()
  for _ = 1, 2 do
    rtf.case("pose", function() end)
  end
end
