--  Tests of an arm, as a user of AUnit writes them.

with AUnit;
with AUnit.Test_Cases;
with AUnit.Test_Fixtures;

package Arm_Tests is

   type Arm_Case is new AUnit.Test_Cases.Test_Case with null record;
   overriding procedure Register_Tests (Self : in out Arm_Case);
   overriding procedure Set_Up (Self : in out Arm_Case);
   overriding function Name (Self : Arm_Case) return AUnit.Message_String;

   --  Its Set_Up_Case fails.
   type Bench_Case is new AUnit.Test_Cases.Test_Case with null record;
   overriding procedure Register_Tests (Self : in out Bench_Case);
   overriding procedure Set_Up_Case (Self : in out Bench_Case);
   overriding function Name (Self : Bench_Case) return AUnit.Message_String;

   type Gripper is new AUnit.Test_Fixtures.Test_Fixture with record
      Fingers : Natural := 0;
   end record;
   overriding procedure Set_Up (Self : in out Gripper);
   procedure Opens (Self : in out Gripper);
   procedure Closes (Self : in out Gripper);

end Arm_Tests;
