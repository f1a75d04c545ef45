function TestCase.run()
  for number = 0, 999999 do
    print("flood line " .. number)
  end
end
