with Arm;
with AUnit.Assertions; use AUnit.Assertions;
with RTF_Session;

package body Rest_Tests is

   use AUnit.Test_Cases;

   Rest : aliased Rest_Case;

   procedure Has_Three_Joints (Self : in out Test_Case'Class);
   procedure Refuses_Unknown_Joints (Self : in out Test_Case'Class);
   procedure Keeps_Time (Self : in out Test_Case'Class);

   procedure Has_Three_Joints (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Assert (Arm.Ask ("joints") = "shoulder elbow wrist", "three joints");
   end Has_Three_Joints;

   procedure Refuses_Unknown_Joints (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
   begin
      Assert (Arm.Ask ("get tail") = "", "a position of a joint that does not exist");
   exception
      when Arm.Refused =>
         null;
   end Refuses_Unknown_Joints;

   procedure Keeps_Time (Self : in out Test_Case'Class) is
      pragma Unreferenced (Self);
      Before  : constant Float := Float'Value (Arm.Ask ("time"));
      Elapsed : Float;
   begin
      delay 0.2;
      Elapsed := Float'Value (Arm.Ask ("time")) - Before;
      Assert (RTF_Session.Measure ("simulated time", Long_Float (Elapsed), "s", 0.01, 5.0),
              "the time of the simulator");
   end Keeps_Time;

   overriding procedure Register_Tests (Self : in out Rest_Case) is
   begin
      Registration.Register_Routine (Self, Has_Three_Joints'Access, "has three joints");
      Registration.Register_Routine
        (Self, Refuses_Unknown_Joints'Access, "refuses unknown joints");
      Registration.Register_Routine (Self, Keeps_Time'Access, "keeps time");
   end Register_Tests;

   overriding function Name (Self : Rest_Case) return AUnit.Message_String is
      pragma Unreferenced (Self);
   begin
      return AUnit.Format ("the arm at rest");
   end Name;

   function Suite return AUnit.Test_Suites.Access_Test_Suite is
      All_Tests : constant AUnit.Test_Suites.Access_Test_Suite := AUnit.Test_Suites.New_Suite;
   begin
      All_Tests.Add_Test (Rest'Access);
      return All_Tests;
   end Suite;

end Rest_Tests;
