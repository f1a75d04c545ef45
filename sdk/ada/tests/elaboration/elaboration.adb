package body Elaboration is

   procedure Calibrate is
   begin
      raise Program_Error with "no calibration";
   end Calibrate;

begin
   Calibrate;
end Elaboration;
